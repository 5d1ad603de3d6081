// The library's instance of the function bodies in <pliant/method/linearly_implicit-inl.h>.
#include <pliant/method/linearly_implicit-inl.h>
