// The library's instance of the function bodies in <pliant/method/explicit_runge_kutta-inl.h>.
#include <pliant/method/explicit_runge_kutta-inl.h>
