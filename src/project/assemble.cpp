// The library's instance of the bodies in <pliant/project/assemble-inl.h>.
#include <pliant/project/assemble-inl.h>
