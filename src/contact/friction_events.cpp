// The library's instance of the function bodies in <pliant/contact/friction_events-inl.h>.
#include <pliant/contact/friction_events-inl.h>
