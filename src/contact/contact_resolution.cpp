// The library's instance of the function bodies in <pliant/contact/contact_resolution-inl.h> and
// <pliant/contact/contact_separation-inl.h>.
#include <pliant/contact/contact_resolution-inl.h>
#include <pliant/contact/contact_separation-inl.h>
