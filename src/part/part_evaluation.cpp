// Compiles the function bodies of part_evaluation-inl.h once.
#include <pliant/part/part_evaluation-inl.h>
