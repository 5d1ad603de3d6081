// The library's instance of the function bodies in <pliant/method/semi_implicit_euler-inl.h>.
#include <pliant/method/semi_implicit_euler-inl.h>
