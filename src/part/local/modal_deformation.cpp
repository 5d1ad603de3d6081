// Compiles the functions of modal_deformation-inl.h once.
#include <pliant/part/local/modal_deformation-inl.h>
