// Compiles the function bodies of part_description-inl.h once.
#include <pliant/part/part_description-inl.h>
