// Compiles the functions of local_deformation-inl.h once.
#include <pliant/part/local/local_deformation-inl.h>
