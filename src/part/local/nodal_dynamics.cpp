// Compiles the functions of nodal_dynamics-inl.h once.
#include <pliant/part/local/nodal_dynamics-inl.h>
