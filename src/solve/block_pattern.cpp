// The library compiles the bodies of this header here.
#include <pliant/solve/block_pattern-inl.h>
