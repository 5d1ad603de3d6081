// The library's instance of the function bodies in <pliant/contact/contact_resolution-inl.h>.
#include <pliant/contact/contact_resolution-inl.h>
