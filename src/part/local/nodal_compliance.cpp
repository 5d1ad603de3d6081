// Compiles the function bodies of nodal_compliance-inl.h once.
#include <pliant/part/local/nodal_compliance-inl.h>
