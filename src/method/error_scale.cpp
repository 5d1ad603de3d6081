// The library's instance of the function bodies in <pliant/method/error_scale-inl.h>.
#include <pliant/method/error_scale-inl.h>
