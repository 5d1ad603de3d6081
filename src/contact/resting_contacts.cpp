// The library's instance of the bodies in <pliant/contact/resting_contacts-inl.h>.
#include <pliant/contact/resting_contacts-inl.h>
