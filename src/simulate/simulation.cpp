// The library's instance of the function bodies in <pliant/simulate/simulation-inl.h> and
// <pliant/simulate/controlled_step-inl.h>.
#include <pliant/simulate/controlled_step-inl.h>
#include <pliant/simulate/simulation-inl.h>
