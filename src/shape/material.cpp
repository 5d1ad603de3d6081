// Compiles the functions of material.h once for the library.
#include <pliant/shape/material-inl.h>
