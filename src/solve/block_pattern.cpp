// Compiles the functions of block_pattern.h once for the library.
#include <pliant/solve/block_pattern-inl.h>
