// The library's instance of the function bodies in <pliant/simulate/partial_state-inl.h>.
#include <pliant/simulate/partial_state-inl.h>
