// Compiles the functions of inertia-inl.h once.
#include <pliant/part/inertia-inl.h>
