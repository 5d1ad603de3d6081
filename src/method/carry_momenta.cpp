// The library's instance of the bodies in <pliant/method/carry_momenta-inl.h>.
#include <pliant/method/carry_momenta-inl.h>
