// The library's instance of the function bodies in <pliant/contact/sleeping-inl.h>.
#include <pliant/contact/sleeping-inl.h>
