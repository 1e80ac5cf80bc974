"""Files of users: scenarios and systems; reading, checking, schemas, expressions."""
