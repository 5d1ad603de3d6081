// Compiles the function bodies of modal_deformation-inl.h once.
#include <pliant/part/local/modal_deformation-inl.h>
