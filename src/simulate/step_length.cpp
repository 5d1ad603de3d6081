// The library's instance of the function bodies in <pliant/simulate/step_length-inl.h>.
#include <pliant/simulate/step_length-inl.h>
