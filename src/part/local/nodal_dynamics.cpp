// Compiles the function bodies of nodal_dynamics-inl.h once.
#include <pliant/part/local/nodal_dynamics-inl.h>
