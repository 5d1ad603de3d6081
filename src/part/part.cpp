// Compiles the function bodies of part-inl.h once.
#include <pliant/part/part-inl.h>
