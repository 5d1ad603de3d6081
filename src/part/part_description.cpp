// Compiles the functions of part_description-inl.h once.
#include <pliant/part/part_description-inl.h>
