// Compiles the function bodies of nodal_forces-inl.h once.
#include <pliant/part/local/nodal_forces-inl.h>
