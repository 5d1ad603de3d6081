// Compiles the functions of nodal_compliance-inl.h once.
#include <pliant/part/local/nodal_compliance-inl.h>
