"""Run by Alembic, on the connection and in the transaction that ``server.store.schema`` gives it.

No ``alembic.ini`` and no logging: the program that migrates has its own.
"""

from alembic import context

from server.store.models import Table

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=Table.metadata,
    render_as_batch=True,
)
with context.begin_transaction():
    context.run_migrations()
