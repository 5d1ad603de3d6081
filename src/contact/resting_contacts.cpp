// The library's instance of the function bodies in <pliant/contact/resting_contacts-inl.h>.
#include <pliant/contact/resting_contacts-inl.h>
