// The library's instance of the bodies in <pliant/method/rk4-inl.h>.
#include <pliant/method/rk4-inl.h>
