// The library's instance of the function bodies in <pliant/method/carry_momenta-inl.h>.
#include <pliant/method/carry_momenta-inl.h>
