// Compiles the bodies of modal_deformation-inl.h once.
#include <pliant/part/local/modal_deformation-inl.h>
