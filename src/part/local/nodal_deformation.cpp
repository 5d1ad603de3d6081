// Compiles the functions of nodal_deformation-inl.h once.
#include <pliant/part/local/nodal_deformation-inl.h>
