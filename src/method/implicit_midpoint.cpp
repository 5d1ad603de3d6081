// The library's instance of the bodies in <pliant/method/implicit_midpoint-inl.h>.
#include <pliant/method/implicit_midpoint-inl.h>
