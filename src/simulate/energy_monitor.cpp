// The library's instance of the function bodies in <pliant/simulate/energy_monitor-inl.h>.
#include <pliant/simulate/energy_monitor-inl.h>
