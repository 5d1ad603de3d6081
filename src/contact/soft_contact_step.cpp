// The library's instance of the function bodies in <pliant/contact/soft_contact_step-inl.h>.
#include <pliant/contact/soft_contact_step-inl.h>
