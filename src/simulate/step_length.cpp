// The library's instance of the bodies in <pliant/simulate/step_length-inl.h>.
#include <pliant/simulate/step_length-inl.h>
