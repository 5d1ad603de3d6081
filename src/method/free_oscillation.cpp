// The library's instance of the function bodies in <pliant/method/free_oscillation-inl.h>.
#include <pliant/method/free_oscillation-inl.h>
