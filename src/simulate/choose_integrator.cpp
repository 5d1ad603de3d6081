// The library's instance of the function bodies in <pliant/simulate/choose_integrator-inl.h>.
#include <pliant/simulate/choose_integrator-inl.h>
