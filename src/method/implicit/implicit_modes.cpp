// The library's instance of the function bodies in <pliant/method/implicit/implicit_modes-inl.h>.
#include <pliant/method/implicit/implicit_modes-inl.h>
