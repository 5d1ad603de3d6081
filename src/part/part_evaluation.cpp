// Compiles the functions of part_evaluation-inl.h once.
#include <pliant/part/part_evaluation-inl.h>
