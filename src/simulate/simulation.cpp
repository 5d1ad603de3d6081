// The library's instance of the function bodies in <pliant/simulate/simulation-inl.h>.
#include <pliant/simulate/simulation-inl.h>
