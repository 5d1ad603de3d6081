// The library's instance of the bodies in <pliant/method/implicit/stiff_pushes-inl.h>.
#include <pliant/method/implicit/stiff_pushes-inl.h>
