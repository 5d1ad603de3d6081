// Compiles the function bodies of inertia-inl.h once.
#include <pliant/part/inertia-inl.h>
