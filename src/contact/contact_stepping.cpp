// The library's instance of the function bodies in <pliant/contact/contact_stepping-inl.h>.
#include <pliant/contact/contact_stepping-inl.h>
