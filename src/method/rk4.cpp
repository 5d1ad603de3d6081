// The library's instance of the function bodies in <pliant/method/rk4-inl.h>.
#include <pliant/method/rk4-inl.h>
