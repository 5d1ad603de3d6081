// The library's instance of the function bodies in <pliant/simulate/clusters-inl.h>.
#include <pliant/simulate/clusters-inl.h>
