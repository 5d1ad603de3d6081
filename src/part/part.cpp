// Compiles the functions of part-inl.h once.
#include <pliant/part/part-inl.h>
