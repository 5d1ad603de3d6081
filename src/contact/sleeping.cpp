// The library's instance of the bodies in <pliant/contact/sleeping-inl.h>.
#include <pliant/contact/sleeping-inl.h>
