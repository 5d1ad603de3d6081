// The library's instance of the function bodies in <pliant/simulate/stable_step-inl.h>.
#include <pliant/simulate/stable_step-inl.h>
