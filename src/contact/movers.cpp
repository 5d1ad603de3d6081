// The library's instance of the function bodies in <pliant/contact/movers-inl.h>.
#include <pliant/contact/movers-inl.h>
