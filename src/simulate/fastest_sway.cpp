// The library's instance of the function bodies in <pliant/simulate/fastest_sway-inl.h>.
#include <pliant/simulate/fastest_sway-inl.h>
