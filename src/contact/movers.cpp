// The library's instance of the bodies in <pliant/contact/movers-inl.h>.
#include <pliant/contact/movers-inl.h>
