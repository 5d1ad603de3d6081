// Compiles the functions of linear_inertia-inl.h once.
#include <pliant/part/linear_inertia-inl.h>
