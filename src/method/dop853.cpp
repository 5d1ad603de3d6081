// The library's instance of the function bodies in <pliant/method/dop853-inl.h>.
#include <pliant/method/dop853-inl.h>
