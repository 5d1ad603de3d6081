// The library's instance of the bodies in <pliant/simulate/fastest_sway-inl.h>.
#include <pliant/simulate/fastest_sway-inl.h>
